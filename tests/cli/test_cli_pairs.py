"""`evenroad pairs` says of every pair that the SRDF disables whether it ever touches."""

import json

import evenroad as er
from evenroad_verify.command import main as verify


def test_pairs_of_the_ur5_are_all_decided(run):
    code, out, _ = run("pairs", "ur5", "--json")
    pairs = {tuple(pair["links"]): pair for pair in json.loads(out)["pairs"]}
    assert pairs["wrist_1_link", "wrist_3_link"]["status"] == "never"
    touching = pairs["base_link", "upper_arm_link"]
    assert (code, touching["status"], len(touching["joints"])) == (1, "touches", 2)
    # A world that tests this pair, as no SRDF disables it, finds the same contact.
    robot = er.load_robot("ur5")
    from dataclasses import replace

    world = er.ArmWorld(replace(robot, pairs=(("base_link", "upper_arm_link"),)))
    assert not world.valid(robot.configuration(touching["configuration"]))


def test_bodies_of_the_user_and_no_time_are_refused(refuse):
    assert "--bodies" in refuse("pairs", "ur5", "--bodies", "capsules")
    assert "--seconds" in refuse("pairs", "ur5", "--seconds", "0")


def test_the_pairs_that_never_touch_are_certified_after_the_table(run, tmp_path):
    file = tmp_path / "pairs.cert"
    code, out, _ = run("pairs", "ur5", "--certificate", str(file), "--embed")
    assert code == 1
    assert "never, proved in" in out
    assert f"certificate of pairs that never touch (1): {file}" in " ".join(out.split())
    assert verify([str(file)]) == 0


def test_a_robot_of_which_all_pairs_touch_gets_its_table_and_no_certificate(run, tmp_path):
    code, out, error = run("pairs", "arm7", "--certificate", str(tmp_path / "pairs.cert"))
    assert code == 2
    assert "adjacent" in out
    assert "no pair of links that is proved never to touch" in " ".join(error.split())
    assert not (tmp_path / "pairs.cert").exists()
