"""The stored results: complete, made from the case files as they are, reproduced by a fresh run."""

import json

from fenicsx import store

from .support import TestCase

LIVE = ("block", "gap-p2-exact-n8", "cantilever-p2-gauss4-n16", "singular-p2-exact-n8", "corner-p1-gauss4-n8", "patch-d3-p2-exact")


class Store(TestCase):
    def test_every_case_has_a_result_made_from_it_and_every_result_a_case(self):
        cases = store.cases()
        self.assertEqual(sorted(cases), sorted(file.stem for file in store.RESULTS.glob("*.json")))
        for name, file in cases.items():
            provenance = json.loads((store.RESULTS / f"{name}.json").read_text())["provenance"]
            self.assertEqual(provenance["case_sha256"], store.sha256(file), f"{name}: run python3 -m fenicsx.store {name}")
            self.assertEqual(store.ROOT / provenance["case"], file)

    def test_some_results_are_reproduced(self):
        known = store.cases()
        for name in LIVE:
            self.assertEqual(store.check(name, known[name]), [])

    def test_control_a_change_in_the_last_digits_compared_is_noticed(self):
        for part, key in (("quantities", "a_uu"), ("quantities", "contact_length"), ("gamma", "kappa"), ("errors", "h1")):
            a = json.loads((store.RESULTS / "singular-p2-exact-n8.json").read_text())
            b = json.loads((store.RESULTS / "singular-p2-exact-n8.json").read_text())
            b[part][key] *= 1 + 3e-11 * (a["quantities"]["a_uu"] ** 0.5 / a[part][key] if part == "errors" else 1)
            self.assertEqual([place for place, value in store.differences(a, b) if value > store.TOLERANCE], [f"{part}.{key}"])
        b["probes"][7][3] += 3e-11 * b["quantities"]["max_displacement"]
        del b["probes"][-1]
        self.assertIn("probes", [place for place, value in store.differences(a, b) if value > store.TOLERANCE])
