"""What a search may spend, and what gives it back."""

from dataclasses import replace

from onehop.contracts.sections import PlannerSection
from robot_agent.core.planning.search_budget import SearchBudget

SECTION = replace(PlannerSection(), inflation=0.5, patience=2.0)


def budget() -> SearchBudget:
    """Of 20 m, begun 50 m from the goal."""
    return SearchBudget(SECTION, 10.0, 50.0)


def test_a_search_ends_when_its_distance_is_spent() -> None:
    search = budget()
    search.spend(19.9)
    assert not search.exhausted
    search.spend(1.0)
    assert search.exhausted
    assert not search.hopeless


def test_a_planning_moment_that_moved_nowhere_spends_half_an_inflation() -> None:
    search = budget()
    search.spend(0.0)
    assert search.spent == 0.25


def test_only_a_record_broken_by_a_step_gives_the_budget_back() -> None:
    search = budget()
    search.spend(30.0)
    assert not search.compare(49.6)
    assert search.record == 49.6
    assert search.exhausted
    assert search.compare(49.4)
    assert not search.exhausted
    assert not search.compare(49.0)


def test_two_thousand_laser_ranges_without_a_record_are_hopeless() -> None:
    search = budget()
    search.spend(20_000.0)
    assert not search.hopeless
    search.spend(0.1)
    assert search.hopeless
