"""The checker of certificates accepts a proof and refuses it when anything in it is tampered with."""

import contextlib
import io
import tempfile
import unittest
from pathlib import Path

from check_certificates import check, main

PROOF = Path(__file__).with_name("quotient.proof").read_text()


def without_path(number):
    head, *paths = PROOF.split("\npath\n")
    del paths[number]
    return "\npath\n".join([head, *paths])


class Certificates(unittest.TestCase):
    def refused(self, text, why):
        self.assertNotEqual(text, PROOF)
        with self.assertRaisesRegex(ValueError, why):
            check(text)

    def test_the_proof_is_accepted(self):
        paths, refuted, digest = check(PROOF, "a_quotient_of_squares_is_not_negative")
        self.assertRegex(digest, "^[0-9a-f]{16}$")
        self.assertEqual(paths, PROOF.count("\npath\n"))
        self.assertGreater(refuted, 0)

    def test_a_path_left_out_is_noticed(self):
        for number in range(PROOF.count("\npath\n")):
            self.refused(without_path(number), "is left out|no path holds")

    def test_an_answer_made_narrower_is_noticed(self):
        self.refused(PROOF.replace("ask <= ", "ask < "), "left out|follow")

    def test_a_weight_changed_is_noticed(self):
        self.refused(PROOF.replace("\nterm 1 |", "\nterm 2 |", 1), "not zero")

    def test_a_negative_weight_is_noticed(self):
        self.refused(PROOF.replace("\nterm 1 |", "\nterm -1 |", 1), "negative")

    def test_a_certificate_left_out_is_noticed(self):
        lines = [line for line in PROOF.split("\n") if not line.startswith(("term", "multiple"))]
        self.refused("\n".join(lines), "no product is positive")

    def test_a_fact_that_no_answer_gives_is_noticed(self):
        at = PROOF.index("\nfact ")
        self.refused(PROOF[:at] + "\nfact > -1" + PROOF[at:], "does not follow|not zero|positive")

    def test_a_fact_with_the_wrong_sign_is_noticed(self):
        self.refused(PROOF.replace("\nfact > -1 a^2", "\nfact > 1 a^2"), "does not follow")

    def test_an_inverse_of_what_may_be_zero_is_noticed(self):
        self.refused(PROOF.replace("ask > 1 b", "ask >= 1 b").replace("ask <= 1 b", "ask < 1 b"), "may be zero")

    def test_a_power_written_as_two_factors_is_that_power(self):
        # "No number is negative": false, and refused however its powers are written.
        unsound = """statement a_number_is_not_negative
unknowns a
path
ask >= 1 a
holds always
path
ask < 1 a
fails a >= S::from(0)
fact > -1 a
term 1 | 0 |
multiple 1 a | 0"""
        squares = unsound.replace("multiple 1 a | 0", "term 1 | | 1 a a")
        for text in (unsound, squares, unsound.replace("multiple 1 a | 0", "term 1 | 0 0 | 1 a^0")):
            self.refused(text, "multiple of an inequality|not zero|exponent")
        self.refused(PROOF.replace("1 a^2", "1 a^-2"), "exponent")
        self.assertEqual(check(PROOF.replace("1 a^2", "1 a a"))[:2], check(PROOF)[:2])

    def test_an_unknown_removed_from_the_head_is_noticed(self):
        self.refused(PROOF.replace("unknowns a b", "unknowns a"), "is no unknown")

    def test_a_proof_under_another_name_is_noticed(self):
        with self.assertRaisesRegex(ValueError, "head of another_theorem"):
            check(PROOF, "another_theorem")

    def test_a_proof_without_a_path_that_holds_is_noticed(self):
        self.refused("statement a_theorem\nunknowns a b\npath\nvacuous", "no path holds")

    def test_another_tree_is_noticed_by_the_ledger(self):
        name = "a_quotient_of_squares_is_not_negative"
        start = PROOF.index("fails ")
        end = PROOF.index("path\n", start)
        paths, refuted, digest = check(PROOF, name)
        # Signs of the first unknown, which say nothing, with as many paths, as many of them refuted and the same class.
        nothing = f"""statement {name}
unknowns a b
path
ask <= 1 a^2 + 1
fails a
fact >= -1 a^2 + -1
term 1 | 0 |
term 1 | | 1 a
term 1 | |
path
ask > 1 a^2 + 1
ask <= 1 a
holds always
path
ask > 1 a^2 + 1
ask > 1 a
vacuous
"""
        self.assertEqual(check(nothing, name)[:2], (paths, refuted))
        with tempfile.TemporaryDirectory() as folder:
            ledger = Path(folder, "VERIFY.md")
            ledger.write_text(f"- [{name}](props/src/claims/a.rs#L7): {paths}/{refuted} {digest}, exact\n")

            def accepted(text):
                Path(folder, f"{name}.proof").write_text(text)
                with contextlib.redirect_stdout(io.StringIO()):
                    return main(folder, ledger) == 0

            self.assertTrue(accepted(PROOF))
            for label in ("holds always", "vacuous"):
                self.assertFalse(accepted(PROOF[:start] + label + "\n" + PROOF[end:]), label)
            self.assertFalse(accepted(PROOF.replace("holds always", "holds sometimes")))
            self.assertFalse(accepted(PROOF.replace("\nvacuous", "\nholds always", 1)))
            self.assertFalse(accepted(nothing))
            ledger.write_text(ledger.read_text() + f"- [another_theorem](a.rs#L1): 1/0 {digest}\n")
            self.assertFalse(accepted(PROOF))
