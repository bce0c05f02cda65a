"""The paper's statements, judged by a whole reproduction: every one gets a verdict, which is recorded."""

import json

import pytest

from whirlmap.studies.gear_psfd.claims.claims import claims
from whirlmap.studies.gear_psfd.reproduction.reproduce import reproduce


@pytest.mark.slow
@pytest.mark.timeout(3000)
def test_every_statement_gets_a_verdict_in_every_edition(tmp_path, validate):
    made = reproduce(tmp_path / "reproduction", workers=2)["verdicts"]
    assert set(made) == {"literal", "intended", "machine"}
    for claim in claims():
        for edition, verdicts in made.items():
            one = verdicts[claim.id]
            validate.claim(f"{claim.id}, {edition}", one["verdict"], one["found"], says=claim.says, source=claim.where)
    assert all(len(verdicts) == len(list(claims())) for verdicts in made.values()), json.dumps(made)
