"""`evenroad pairs` says of every pair that the SRDF disables whether it ever touches."""

import json

import evenroad as er


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
