"""The paper's experiments in their quick settings: what they must come to."""

import csv
from pathlib import Path

import pytest

pytest.importorskip("torch")
pytest.importorskip("matplotlib")
pytest.importorskip("tqdm")


def rows(file: Path) -> list[dict[str, str]]:
    with file.open(encoding="utf-8", newline="") as text:
        return list(csv.DictReader(text))


def test_cartpole_stays_up_after_one_trajectory(tmp_path: Path) -> None:
    pytest.importorskip("gymnasium")
    from tangency.experiments.cartpole.__main__ import main

    main(["--quick", "--out", str(tmp_path)])
    physics = [row for row in rows(tmp_path / "points.csv") if row["model"] == "physics"]
    for row in physics:
        cart, pole, length = map(float, row["numbers"].split())
        assert (cart, length) == pytest.approx((1.0, 0.5), rel=5e-3)
        assert pole == pytest.approx(0.1, rel=0.1)
        rewards = [int(reward) for reward in row["rewards"].split()]
        assert sum(rewards) / len(rewards) >= 990
    page = (tmp_path / "README.md").read_text(encoding="utf-8")
    assert "figure.svg" in page and (tmp_path / "figure.svg").exists()


def test_billiards_learn_better_with_physics_inside(tmp_path: Path) -> None:
    pytest.importorskip("cv2")
    from tangency.experiments.billiards.__main__ import main

    main(["--quick", "--out", str(tmp_path)])
    test = {row["step"]: float(row["test"]) for row in rows(tmp_path / "runs.csv")}
    assert test["physics"] < 0.02  # squared sides; places drawn at random are 0.1 from each other
    assert test["physics"] < test["network"]
    assert (tmp_path / "labels.svg").exists() and (tmp_path / "frames.svg").exists()


def test_identification_finds_numbers_within_their_error_bars(tmp_path: Path) -> None:
    from tangency.experiments.identification.__main__ import main

    main(["--quick", "--out", str(tmp_path)])
    found = rows(tmp_path / "numbers.csv")
    assert len(found) == 10
    for row in found:
        true, mean, bar = (float(row[key]) for key in ("true", "mean estimate", "error bar"))
        assert abs(mean - true) < 4.0 * bar / 20**0.5 + 1e-5  # a mean of 20; five decimals are written
    shares = [float(row["within 2 bars"].rstrip("%")) for row in found]
    assert sum(shares) / len(shares) > 88.0  # 95.4 % of 200 that are not independent
