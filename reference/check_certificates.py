"""Checks the proofs that `cargo run -p props -- export DIR` writes, knowing nothing of the engine that found them.

    python3 reference/check_certificates.py DIR [VERIFY.md]

Of each file NAME.proof: the questions of its paths are a tree in which the answers to a question leave out no sign that
is still possible, so every point lies on a path; and each path that ends in `fails` contradicts itself: its facts follow
from its answers, and its certificate, weights >= 0 times products of facts and squares plus multiples of equations, is
zero, though one product is positive. The statement is that of the file's name, and only its unknowns occur. With
VERIFY.md, each proof listed there has its file, with as many paths, as many of them refuted, and the hash of its tree, which is the
file without facts and certificates: another predicate, or a path that is called something else, is seen there. Format:
transcript.rs in props/src/proof. Fractions and integers only.
"""
import hashlib, re, sys
from fractions import Fraction
from pathlib import Path

SIGNS = {"<": {-1}, "<=": {-1, 0}, "=": {0}, ">=": {0, 1}, ">": {1}}


def polynomial(text):
    """A dict from monomials, sorted tuples of (name, exponent >= 1) with each name once, to coefficients."""
    sum = {}
    for term in text.split(" + "):
        number, *factors = term.split()
        powers = {}
        for factor in factors:
            name, power, exponent = factor.partition("^")
            demand(re.fullmatch(r"[a-z_]\w*", name, re.A | re.I), f"'{factor}' is no power of an unknown")
            demand(not power or re.fullmatch(r"[1-9][0-9]*", exponent, re.A), f"the exponent of '{factor}'")
            powers[name] = powers.get(name, 0) + int(exponent or 1)
        monomial = tuple(sorted(powers.items()))
        sum[monomial] = sum.get(monomial, 0) + Fraction(number)
    return {m: c for m, c in sum.items() if c}


def times(p, q):
    sum = {}
    for m, c in p.items():
        for n, d in q.items():
            powers = dict(m)
            for name, exponent in n:
                powers[name] = powers.get(name, 0) + exponent
            monomial = tuple(sorted(powers.items()))
            sum[monomial] = sum.get(monomial, 0) + c * d
    return {m: c for m, c in sum.items() if c}


def plus(p, q):
    return {m: c for m in p.keys() | q.keys() if (c := p.get(m, 0) + q.get(m, 0))}


def scaled(p, signs):
    """The same statement about the sign of p divided by its leading coefficient, as (key, signs)."""
    lead = p[max(p)]
    key = frozenset((m, c / lead) for m, c in p.items())
    return key, {sign if lead > 0 else -sign for sign in signs}


def demand(condition, what):
    if not condition:
        raise ValueError(what)


def contradicts(lines, known):
    facts, sum, strict = [], {}, False
    for line in lines:
        kind, _, rest = line.partition(" ")
        if kind == "fact":
            relation, _, text = rest.partition(" ")
            demand(relation in (">", ">=", "="), f"a fact with {relation}")
            facts.append((relation, polynomial(text)))
            key, signs = scaled(facts[-1][1], SIGNS[relation])
            demand(known.get(key, {-1, 0, 1}) <= signs, f"fact '{rest}' does not follow from the answers")
            continue
        parts = [part.strip() for part in rest.split("|")]
        if kind == "term":
            weight, numbers = Fraction(parts[0]), [int(n) for n in parts[1].split()]
            squares = [polynomial(text) for text in parts[2].split(" ; ") if text]
            demand(weight >= 0 and min(numbers, default=0) >= 0, "a negative weight or number")
            demand(all(facts[n][0] != "=" for n in numbers), "an equation in a product")
            strict |= weight > 0 and not squares and all(facts[n][0] == ">" for n in numbers)
            product = {(): weight} if weight else {}
            for factor in [facts[n][1] for n in numbers] + squares + squares:
                product = times(product, factor)
        else:
            demand(kind == "multiple" and int(parts[1]) >= 0, f"'{line}'")
            demand(facts[int(parts[1])][0] == "=", "a multiple of an inequality")
            product = times(polynomial(parts[0]), facts[int(parts[1])][1])
        sum = plus(sum, product)
    demand(strict, "no product is positive")
    demand(not sum, f"the sum is not zero: {sum}")


def covers(paths, known, depth=0):
    """Checks the paths, [steps, end, certificate] each, which have their first `depth` steps in common. Counts those that fail."""
    if any(len(steps) == depth for steps, _, _ in paths):
        demand(len(paths) == 1, "a path goes on where another one ends")
        (_, end, certificate), = paths
        demand(re.match(r"holds .|vacuous$|fails .", end), f"a path ends in '{end}'")
        if end.startswith("fails"):
            contradicts(certificate, known)
        return int(end.startswith("fails"))
    steps = {steps[depth] for steps, _, _ in paths}
    kind, name, text = min(steps)
    p = polynomial(text)
    if kind == "inverse":
        key, nonzero = scaled(p, {-1, 1})
        signs = known.get(key, {-1, 0, 1})
        demand(len(steps) == 1 and signs <= nonzero, f"the inverse of {text}, which may be zero")
        demand(not any(name in dict(m) for key in known for m, _ in key), f"{name} is not new")
        x = {((name, 1),): Fraction(1)}
        product, zero = scaled(plus(times(p, x), {(): Fraction(-1)}), {0})
        sign = scaled(p, {1})[1] == {1}
        known = {**known, product: zero, scaled(x, {1})[0]: signs if sign else {-s for s in signs}}
        return covers(paths, known, depth + 1)
    demand({step[0] for step in steps} == {"ask"}, "different steps after the same answers")
    answers = {step: scaled(polynomial(step[2]), SIGNS[step[1]]) for step in steps}
    demand(len({key for key, _ in answers.values()}) == 1, "different questions after the same answers")
    key = next(iter(answers.values()))[0]
    left_out = known.get(key, {-1, 0, 1}) - set().union(*(signs for _, signs in answers.values()))
    demand(not left_out, f"the sign {left_out} of {text} is left out")
    below = lambda step: [path for path in paths if path[0][depth] == step]
    return sum(covers(below(step), {**known, key: signs}, depth + 1) for step, (_, signs) in answers.items())


def check(text, name=None):
    """The paths, the paths refuted and the hash of the tree; a ValueError says what is wrong."""
    head, *blocks = text.split("\npath\n")
    title = re.fullmatch(r"statement (\w+)\nunknowns((?: \w+)*) ?", head, re.A)
    demand(title and name in (None, title[1]), f"the head of {name} is '{head}'")
    unknowns = title[2].split()
    demand(len(set(unknowns)) == len(unknowns), "an unknown twice")
    paths, classes = [], set()
    for block in blocks:
        lines = block.strip().split("\n")
        of = [line for line in lines if line.startswith(("ask ", "inverse "))]
        demand(lines[: len(of)] == of and len(lines) > len(of), "a step after the end of a path")
        steps = [tuple(line.split(" ", 2)) for line in of]
        inverses = [s[1] for s in steps if s[0] == "inverse"]
        demand(not set(inverses) & set(unknowns), "an inverse that is an unknown")
        end, certificate = lines[len(of)], lines[len(of) + 1 :]
        demand(end.startswith("fails ") or not certificate, "a certificate of a path that does not fail")
        shown = [s[2] for s in steps] + [part for line in certificate for part in certified(line)]
        used = {name for text in shown for m in polynomial(text) for name, _ in m}
        demand(used <= {*unknowns, *inverses}, f"{used - {*unknowns, *inverses}} is no unknown")
        classes |= {end[6:]} if end.startswith("holds ") else set()
        paths.append((steps, end, certificate))
    demand(classes, "no path holds: nothing is said of anything")
    return len(paths), covers(paths, {}), tree(text)


def tree(text):
    """The hash of what is proved: questions, answers and ends, without facts and certificates."""
    lines = [line + "\n" for line in text.splitlines() if not line.startswith(("fact ", "term ", "multiple "))]
    return hashlib.sha256("".join(lines).encode()).hexdigest()[:16]


def certified(line):
    """The polynomials of a line of a certificate."""
    kind, _, rest = line.partition(" ")
    if kind == "fact":
        return [rest.partition(" ")[2]]
    parts = rest.split("|")
    return [text for text in parts[2].split(" ; ") if text.strip()] if kind == "term" else parts[:1]


def listed(ledger):
    """The proofs of VERIFY.md: by name, paths, paths refuted and hash of the tree."""
    lines = re.findall(r"^- \[(\w+)\]\([^)]*\): (\d+)/(\d+) ([0-9a-f]{16})\b", Path(ledger).read_text(), re.M)
    demand(lines, f"{ledger} lists no proof")
    return {name: (int(paths), int(refuted), digest) for name, paths, refuted, digest in lines}


def main(directory, ledger=None):
    files = {path.stem: path for path in sorted(Path(directory).glob("*.proof"))}
    expected = listed(ledger) if ledger else {}
    wrong = [f"{name}: in {ledger}, not exported" for name in sorted(expected.keys() - files.keys())]
    wrong += [f"{name}: exported, not in {ledger}" for name in sorted(files.keys() - expected.keys()) if ledger]
    total = [0, 0]
    for name, path in files.items():
        try:
            found = check(path.read_text(), name)
            demand(found == expected.get(name, found), f"{found}, but {ledger} says {expected.get(name)}")
            total = [a + b for a, b in zip(total, found)]
        except (ValueError, IndexError, KeyError) as why:
            wrong.append(f"{name}: {why!r}")
    print(f"{len(files)} proofs, {total[0]} paths, {total[1]} refuted by certificates; {len(wrong)} wrong", *wrong, sep="\n")
    return 1 if wrong or not files else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
