"""Pairs of bodies: the stored results are complete and made from the case files as they are; a fresh run gives them again, and that of another
method does not."""

import json

from fenicsx import pair, store

from .support import TestCase


class Pairs(TestCase):
    def test_every_case_has_a_result_made_from_it_and_every_result_a_case(self):
        cases = pair.cases()
        self.assertEqual(sorted(cases), sorted(file.stem for file in pair.STORED.glob("*.json")))
        for name, file in cases.items():
            provenance = json.loads((pair.STORED / f"{name}.json").read_text())["provenance"]
            self.assertEqual(provenance["case_sha256"], store.sha256(file), f"{name}: run python3 -m fenicsx.pair {name}")

    def test_a_result_is_reproduced_and_another_gamma_is_noticed(self):
        for name in ("joined-contact-p1", "apart-p1"):
            file = pair.cases()[name]
            self.assertIsNone(pair.check(name, file))
            other = pair.model(file)(file, kappa=0.55).solve()
            self.assertGreater(pair.difference(self.stored(name), other), 1e3 * pair.TOLERANCE)

    def test_stretches_that_do_not_end_where_the_other_body_has_a_node_are_noticed(self):
        file = pair.cases()["apart-p2"]
        other = pair.Apart(file, merged=False).solve()
        self.assertGreater(pair.difference(self.stored("apart-p2"), other), 1e3 * pair.TOLERANCE)

    @staticmethod
    def stored(name):
        return json.loads((pair.STORED / f"{name}.json").read_text())
