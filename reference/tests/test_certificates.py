"""The checker of certificates accepts a proof and refuses it when anything in it is tampered with."""

import unittest
from pathlib import Path

from check_certificates import check

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
        paths, refuted = check(PROOF)
        self.assertEqual(paths, PROOF.count("\npath\n"))
        self.assertGreater(refuted, 0)

    def test_a_path_left_out_is_noticed(self):
        for number in range(PROOF.count("\npath\n")):
            self.refused(without_path(number), "is left out")

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
