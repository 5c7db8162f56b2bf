"""Breakout: what is found in frames, the paddle's model, what is learned, and that players play."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("ale_py")

import tangency  # noqa: E402
from tangency.experiments.breakout import learn  # noqa: E402
from tangency.experiments.breakout.frames import see  # noqa: E402
from tangency.experiments.breakout.game import Action, Game, Image  # noqa: E402
from tangency.experiments.breakout.learn import Experience  # noqa: E402
from tangency.experiments.breakout.model import Numbers, scene  # noqa: E402
from tangency.experiments.breakout.player import Eyes, Follower, Planner, Player, Random, play  # noqa: E402

RED = (200, 72, 72)
ROWS = (RED, (198, 108, 58), (180, 122, 48), (162, 162, 42), (72, 160, 72), (66, 72, 200))
GREY = (142, 142, 142)


def drawn(paddle: int = 99, width: int = 16, bricks: bool = True) -> Image:
    """A frame with walls, digits and paddle, and all bricks or none."""
    frame = np.zeros((210, 160, 3), dtype=np.uint8)
    frame[5:15, 36:48] = frame[17:32] = frame[32:196, :8] = frame[32:196, 152:] = GREY
    frame[189:195, 152:] = RED
    for row, colour in enumerate(ROWS if bricks else ()):
        frame[57 + 6 * row : 63 + 6 * row, 8:152] = colour
    frame[189:193, paddle : paddle + width] = RED
    return frame


def with_ball(frame: Image, x: int, y: int) -> Image:
    """Draws the ball with its upper left pixel there, in the colours of the rows that it is in."""
    for row in range(y, y + 4):
        frame[row, x : x + 2] = ROWS[(row - 57) // 6] if 57 <= row < 93 else RED
    return frame


def test_paddle_and_bricks_are_found() -> None:
    sight = see(drawn())
    assert sight.paddle == (99, 115) and sight.ball is None
    assert sight.bricks.shape == (6, 18) and sight.bricks.all()
    assert not see(drawn(bricks=False)).bricks.any()


def test_paddle_at_the_walls_and_a_narrow_one() -> None:
    assert see(drawn(paddle=8)).paddle == (8, 24)
    assert see(drawn(paddle=144)).paddle == (144, 152)  # half behind the wall
    assert see(drawn(paddle=60, width=8)).paddle == (60, 68)


@pytest.mark.parametrize("y", [34, 56, 57, 61, 75, 91, 120, 186, 188])
def test_ball_is_found_in_every_colour(y: int) -> None:
    assert see(with_ball(drawn(bricks=False), 40, y)).ball == (41.0, y + 2.0)


def test_ball_beside_a_brick_and_in_a_gap() -> None:
    frame = drawn()
    frame[69:75, 40:48] = 0  # the brick in column 4 of row 2
    frame = with_ball(frame, 46, 70)
    sight = see(frame)
    assert sight.ball == (47.0, 72.0)
    assert not sight.bricks[2, 4] and sight.bricks.sum() == 6 * 18 - 1


def test_ball_beside_the_paddle_and_behind_bricks() -> None:
    assert see(with_ball(drawn(), 60, 189)).ball == (61.0, 191.0)
    assert see(with_ball(drawn(), 60, 189)).paddle == (99, 115)
    assert see(with_ball(drawn(), 60, 64)).ball is None


def test_what_is_too_large_is_no_ball() -> None:
    frame = drawn()
    frame[120:130, 40:60] = RED
    assert see(frame).ball is None


def test_frames_of_another_shape_are_refused() -> None:
    with pytest.raises(ValueError, match=r"frame has shape \(84, 84, 3\); give \(210, 160, 3\)"):
        see(np.zeros((84, 84, 3), dtype=np.uint8))


def test_real_frames_agree_with_the_memory_of_the_game() -> None:
    game, follower, seen = Game(3), Follower(), 0
    for _ in range(600):
        sight = see(game.frame())
        memory = game._ale.getRAM()
        x, y, paddle = int(memory[99]) - 48, int(memory[101]) + 11, int(memory[72]) - 47
        if sight.ball is not None and 95 < y < 187 and 9 <= x <= 151:  # no part behind a wall
            assert sight.ball == (x, y)
            seen += 1
        if sight.paddle is not None:
            assert sight.paddle[0] == paddle
        game.act(follower.act(game.frame()))
    assert seen > 200 and game.score > 0


def test_a_hidden_ball_moves_on_and_is_given_up() -> None:
    eyes = Eyes()
    for k in range(3):
        eyes.look(with_ball(drawn(), 40 + 2 * k, 110 - 3 * k))
    assert eyes.ball == (45.0, 106.0) and eyes.velocity == (2.0, -3.0) and not eyes.falling
    eyes.look(drawn())
    assert eyes.ball == (47.0, 103.0)
    for _ in range(20):
        eyes.look(drawn())
    assert eyes.ball is None
    assert any(eyes.serve or eyes.look(drawn()) for _ in range(2))


def test_the_paddle_of_the_model_is_the_recursion() -> None:
    numbers = Numbers(left=5.0, right=6.0, drag=1.5, delay=1)
    pushes = [1, 1, -1, 0, -1, 1]
    forces = np.array([[numbers.force(push)] for push in pushes])
    model = scene(numbers.drag)
    run = tangency.rollout(model, len(pushes), forces)
    x, v = 80.0, 0.0
    for k, push in enumerate(pushes):
        v = (v + 1.5 * push * (5.0 if push < 0 else 6.0)) / 2.5
        x += v
        assert run.q[k + 1, model.body("paddle"), 0] == pytest.approx(x, abs=1e-9)


def test_the_ball_of_the_model_keeps_its_speed_at_the_walls() -> None:
    model = scene(1.0)
    ball, state = model.body("ball"), model.initial_state
    v = np.zeros_like(state.v)
    v[ball, :2] = 2.0, 3.0
    run = tangency.rollout(model, 60, np.zeros((60, 1)), state=tangency.State(state.q, v))
    assert np.abs(run.v[:, ball, 0]) == pytest.approx(2.0, abs=1e-6)
    assert np.abs(run.v[:, ball, 1]) == pytest.approx(3.0, abs=1e-6)
    assert run.v[-1, ball, :2] == pytest.approx([-2.0, -3.0], abs=1e-6)


def invented(numbers: Numbers, frames: int) -> Experience:
    """What a paddle with these numbers shows, to the pixel's fraction."""
    rng = np.random.default_rng(0)
    pushes = np.repeat(rng.integers(-1, 2, frames // 4), 4)
    places, speed = [70.0], 0.0
    for k in range(pushes.size):
        push = int(pushes[k - numbers.delay]) if k >= numbers.delay else 0
        speed = (speed + numbers.force(push)) / (1.0 + numbers.drag)
        places.append(places[-1] + speed)
    return Experience(np.array(places), pushes)


def test_the_derivative_of_the_loss_is_that_of_differences() -> None:
    data = learn._Stretches.of(invented(Numbers(5.0, 6.0, 1.2, 1), 60), 1)
    x = np.concatenate([np.log([4.0, 4.5, 2.0]), data.places[:, 0] + 0.3, data.speeds - 0.2])
    _, slope = learn.loss(data, x)
    for k in (0, 1, 2, 3, x.size - 1):
        step = np.zeros_like(x)
        step[k] = 1e-5
        difference = (learn.loss(data, x + step)[0] - learn.loss(data, x - step)[0]) / 2e-5
        assert slope[k] == pytest.approx(difference, rel=1e-6, abs=1e-8)


def test_learning_finds_the_numbers_and_the_delay() -> None:
    found, error = learn.learn(invented(Numbers(5.0, 6.0, 1.2, 1), 100))
    assert found.delay == 1 and error < 0.05
    assert (found.left, found.right, found.drag) == pytest.approx((5.0, 6.0, 1.2), rel=0.02)


def test_too_little_experience_is_refused() -> None:
    with pytest.raises(ValueError, match="experience has 8 frames and no stretch"):
        learn.learn(invented(Numbers(5.0, 6.0, 1.2, 1), 8))


def test_real_experience_has_the_speed_of_the_game() -> None:
    found, error = learn.learn(learn.random_play(100, 6))
    assert found.delay == 1 and error < 0.5
    assert (found.left, found.right) == pytest.approx((5.7, 5.7), rel=0.15)  # 23 pixels in 4 frames of a lasting push


@pytest.mark.parametrize("player", [Random(0), Follower(), Planner(Numbers(5.7, 5.7, 1.0, 1), 0)])
def test_players_play(player: Player) -> None:
    game = play(player, seed=1, most_frames=700)
    assert game.over or game.frames == 700
    if not isinstance(player, Random):
        assert game.lives == 5 and game.score > 0


def test_games_and_players_repeat() -> None:
    first, second = (play(Planner(Numbers(5.7, 5.7, 1.0, 1), 4), 4, 300) for _ in range(2))
    assert first.score == second.score and np.array_equal(first.frame(), second.frame())


def test_a_lost_ball_is_served_again() -> None:
    class Idle(Follower):
        """Serves, and does nothing else."""

        def act(self, frame: Image) -> Action:
            return Action.FIRE if super().act(frame) is Action.FIRE else Action.NOOP

    game = play(Idle(), seed=2, most_frames=3000)
    assert game.over and game.lives == 0
