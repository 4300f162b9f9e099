#!/usr/bin/env python3
"""Plants the mistakes of `props/planted.toml` in the sources, one at a time, and asks what is named there: a check of VERIFY.md
(`row` and `check`), a test of `tests/suite` (`test`), one of `props/tests/program` (`program`), or one beside the code (`unit`).

    python3 .ci/planted.py --all              every mistake must be noticed by its check, and no check without one; date and count
                                              of the run are written into props/mutants.md
    python3 .ci/planted.py --only PATTERN     those whose name it matches
    python3 .ci/planted.py --check            none is planted: only that each text is found in the sources
    python3 .ci/planted.py --survey           all rows for each: which checks notice it (hours)

The sources themselves stay as they are: a copy of them is made in the target folder, in which `old` becomes

    (if crate::planted::on(K) { new } else { old })

for every mistake at once, so that the program is built once; PLANTED=K turns mistake K on. So `old` and `new` are expressions
(an assignment is one), and `old` must be found exactly once in its file, after the text `after` if there is one: otherwise
nothing is run. Mistakes whose texts overlap are built one after the other. What was found is written as a table.
"""

import argparse
import datetime
import os
import pathlib
import re
import shutil
import subprocess
import sys
import time
import tomllib

ROOT = pathlib.Path(__file__).resolve().parent.parent
TARGET = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")).absolute() / "planted"
TREE = TARGET / "tree"
# Of its own: cargo tells workspaces apart by what is in them, not by where they are.
BUILD = TARGET / "build"
PROGRAM = BUILD / "debug/props"
# Each crate has a switch of its own.
CRATES = {"src": "signorini", "src/kernel": "signorini-kernel", "src/audit": "signorini-audit", "study/src": "study"}
SWITCH = """//! Which of the planted mistakes is on: `.ci/planted.py`.

/// Whether it is mistake `k`.
pub fn on(k: u32) -> bool {
    static PLANTED: std::sync::OnceLock<u32> = std::sync::OnceLock::new();
    *PLANTED.get_or_init(|| std::env::var("PLANTED").ok().and_then(|k| k.parse().ok()).unwrap_or(0)) == k
}
"""
KEYS = {"name", "file", "old", "new"}


def is_a_test(path):
    """Whether the file of a test declares it, as a function or as a line of `properties!`."""
    *modules, name = path.split("::")
    file = ROOT / "tests/suite" / ("/".join(modules) + ".rs")
    text = file.read_text() if file.is_file() else ""
    return f"fn {name}(" in text or f"    {name}:" in text


def is_of_the_program(path):
    """Whether a line of `checks!` in props/tests/program has this name."""
    module, _, name = path.partition("::")
    file = ROOT / f"props/tests/program/{module}.rs"
    return file.is_file() and f"    {name} => " in file.read_text()


def is_a_unit_test(entry):
    """Whether the crate with the mistake has a test of this name beside the code."""
    module, _, name = entry["unit"].partition("::tests::")
    folder = ROOT / package(entry) / module.replace("::", "/")
    files = folder.with_suffix(".rs"), folder / "mod.rs", folder / "tests.rs"
    return any(f"fn {name}(" in file.read_text() for file in files if file.is_file())


def test_of(entry):
    """Of which program the test of an entry is, as cargo is told, and its name there; nothing for a check of VERIFY.md."""
    if "unit" in entry:
        crate = CRATES[package(entry)]
        return ("-p", "units") if crate == "signorini" else ("-p", crate, "--lib"), entry["unit"]
    if "program" in entry:
        return ("-p", "props", "--lib"), f"program::{entry['program']}::check"
    return (("--test", "suite"), entry["test"]) if "test" in entry else (None, None)


def is_an_expression(text):
    """Whether a text may be one: no statement, and its brackets are closed."""
    closed = all(text.count(left) == text.count(right) for left, right in ("()", "[]", "{}"))
    return closed and not re.search(r"^let |[;=]$", text)


def package(entry):
    """The folder of the crate with the file of a mistake."""
    return next(crate for crate in reversed(CRATES) if entry["file"].startswith(f"{crate}/"))


def mistakes(path):
    """The mistakes, numbered from 1, each with the place of its text."""
    found, wrong, names = [], [], set()
    claims = "".join(file.read_text() for file in (ROOT / "props/src").rglob("*.rs"))
    for k, entry in enumerate(tomllib.loads(path.read_text())["mistake"], 1):
        what = f"{path.name}, mistake {k} ({entry.get('name')})"
        asked = next(({key} for key in ("test", "program", "unit") if key in entry), {"row", "check"})
        if missing := (KEYS | asked) - entry.keys():
            wrong.append(f"{what}: no {', '.join(sorted(missing))}")
            continue
        if "test" in entry and not is_a_test(entry["test"]):
            wrong.append(f"{what}: no test {entry['test']}")
        if "program" in entry and not is_of_the_program(entry["program"]):
            wrong.append(f"{what}: no test {entry['program']} of props/tests/program")
        if "unit" in entry and not is_a_unit_test(entry):
            wrong.append(f"{what}: no test {entry['unit']} beside the code")
        if "check" in entry and not re.search(rf"\b{entry['check']}\b", claims):
            wrong.append(f"{what}: no check {entry['check']}")
        if not all(is_an_expression(entry[key]) for key in ("old", "new")):
            wrong.append(f"{what}: expected expressions")
        if entry["name"] in names:
            wrong.append(f"{what}: the name is there twice")
        names.add(entry["name"])
        source = ROOT / entry["file"]
        text = source.read_text() if source.is_file() else ""
        begin = text.find(entry["after"]) if "after" in entry else 0
        count = text.count(entry["old"], begin) if begin >= 0 else 0
        if "after" in entry and count > 1:
            count = 1
        if count != 1:
            wrong.append(f"{what}: found {count} times in {entry['file']}, expected once: {entry['old']}")
            continue
        start = text.index(entry["old"], begin)
        found.append(entry | {"number": k, "span": (start, start + len(entry["old"]))})
    if wrong:
        sys.exit("\n".join(wrong))
    return found


def batches(entries):
    """Groups of mistakes whose texts do not overlap."""
    groups = []
    for entry in entries:
        start, end = entry["span"]
        for group in groups:
            if all(e["file"] != entry["file"] or e["span"][1] <= start or end <= e["span"][0] for e in group):
                group.append(entry)
                break
        else:
            groups.append([entry])
    return groups


def plant(group):
    """A copy of the sources with all mistakes of a group behind the switch."""
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT, capture_output=True, check=True, text=True,
    ).stdout
    texts = {name: (ROOT / name).read_bytes() for name in listed.split("\0") if name and (ROOT / name).is_file()}
    by_file = {}
    for entry in group:
        by_file.setdefault(entry["file"], []).append(entry)
    for name, entries in by_file.items():
        text = texts[name].decode()
        for entry in sorted(entries, key=lambda e: -e["span"][0]):
            start, end = entry["span"]
            way = f"(if crate::planted::on({entry['number']}) {{ {entry['new']} }} else {{ {entry['old']} }})"
            text = text[:start] + way + text[end:]
        texts[name] = text.encode()
    for crate in CRATES:
        texts[f"{crate}/planted.rs"] = SWITCH.encode()
        texts[f"{crate}/lib.rs"] += b"\npub mod planted;\n"
    # What differs only: cargo builds again what is newer.
    for name, text in texts.items():
        path = TREE / name
        if not path.is_file() or path.read_bytes() != text:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(text)
    for path in [p for p in TREE.rglob("*") if p.is_file()]:
        if str(path.relative_to(TREE)) not in texts:
            path.unlink()


def build(*command):
    """The audit, or the tests, with the mistakes; what cargo says of it."""
    done = subprocess.run(["cargo", *command, "--target-dir", str(BUILD)], cwd=TREE, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{done.stderr}\nthe mistakes do not compile: expected an expression in each `old` and `new`")
    return done.stderr


def ask_test(program, number, test, seconds):
    """The same of a test."""
    environment = os.environ | {"PLANTED": str(number), "NO_COLOR": "1"}
    try:
        done = subprocess.run(
            [program, "--exact", test], cwd=TREE, env=environment, capture_output=True, text=True, timeout=seconds
        )
    except subprocess.TimeoutExpired:
        return None
    if "test result: ok. 1 passed" in done.stdout:
        return {}
    return {test if "test result: FAILED" in done.stdout else "(no report)": done.stdout.strip().splitlines()[-1:]}


def ask(number, row=None, check=None, seconds=600):
    """The names of the checks that fail with a mistake (0: none) on, and what they say; None if there is no answer."""
    regressions = TREE / "props/regressions"
    shutil.rmtree(regressions, ignore_errors=True)
    shutil.copytree(ROOT / "props/regressions", regressions)
    environment = os.environ | {"CARGO_TARGET_DIR": str(TARGET), "PLANTED": str(number), "NO_COLOR": "1"}
    command = [str(PROGRAM), "audit"] + [part for part in (row, check) if part]
    try:
        done = subprocess.run(command, cwd=TREE, env=environment, capture_output=True, text=True, timeout=seconds)
    except subprocess.TimeoutExpired:
        return None
    if done.returncode not in (0, 1):
        return {"(no report)": (done.stderr or done.stdout).strip().splitlines()[-1:]}
    return dict(re.findall(r"^FAILED in row \d+: [a-zA-Z ]+? (\w+): (.*)$", done.stdout, re.M))


def keep(noticed, count):
    """Writes when the whole list was planted last, and what came of it."""
    page = ROOT / "props/mutants.md"
    said = f"The whole list was run last on {datetime.date.today().isoformat()}: {noticed} of {count} were noticed."
    text, places = re.subn(r"The whole list was run last on [-\d]+: \d+ of \d+ were noticed\.", said, page.read_text())
    if places != 1:
        sys.exit(f"{page}: expected one sentence 'The whole list was run last on ..'")
    page.write_text(text)


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--all", action="store_true")
    arguments.add_argument("--only", default="", metavar="PATTERN")
    arguments.add_argument("--check", action="store_true")
    arguments.add_argument("--survey", action="store_true")
    arguments.add_argument("--seconds", type=float, default=600)
    options = arguments.parse_args()
    if options.all == bool(options.only or options.check or options.survey):
        arguments.error("expected one of --all, --only PATTERN, --check and --survey")
    entries = [e for e in mistakes(ROOT / "props/planted.toml") if re.search(options.only, e["name"])]
    if options.check:
        print(f"{len(entries)} mistakes, each found in the sources")
        return
    table, bad, asked = [], 0, set()
    for group in batches(entries):
        plant(group)
        if options.survey or any("row" in entry for entry in group):
            build("build", "--quiet", "-p", "props")
        programs = {}
        for entry in group:
            row, check = (None if options.survey else entry.get(key) for key in ("row", "check"))
            of, test = (None, None) if options.survey else test_of(entry)
            if of and of not in programs:
                said = build("test", *of, "--no-run")
                programs[of] = str(TREE / said.rsplit("(", 1)[1].split(")")[0])

            def asking(number):
                if test:
                    return ask_test(programs[of], number, test, options.seconds)
                return ask(number, row, check, options.seconds)

            if (row, check, test) not in asked:
                asked.add((row, check, test))
                if (failed := asking(0)) != {}:
                    bad += 1
                    print(f"WITHOUT A MISTAKE, {test or check or 'all checks'}: {failed}", flush=True)
            start = time.monotonic()
            failed = asking(entry["number"])
            took = time.monotonic() - start
            if failed is None:
                verdict = "no answer in time"
            elif failed and "(no report)" not in failed:
                verdict = f"noticed by {', '.join(f'`{name}`' for name in failed)}"
            else:
                verdict = f"SURVIVES {failed or ''}"
            bad += not verdict.startswith("noticed")
            print(f"{entry['name']}: {verdict} ({took:.0f} s)", flush=True)
            table.append(f"| {entry['name']} | `{entry['file']}` | {entry.get('row', test_of(entry)[1])} | {verdict} |")
    head = ["| mistake | file | row | found |", "| --- | --- | --- | --- |"]
    (TARGET / "table.md").write_text("\n".join(head + table) + "\n")
    if options.all:
        keep(sum("| noticed" in line for line in table), len(table))
    print(f"{len(table)} mistakes, {bad} not noticed; written: {TARGET / 'table.md'}")
    sys.exit(1 if bad else 0)


if __name__ == "__main__":
    main()
