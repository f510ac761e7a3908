from dynastar.navigator.progress import Progress


def started(now=10.0):
    progress = Progress()
    progress.restart(now)
    progress.note(now, 5.0, 1.0)
    return progress


def test_coming_nearer_counts_and_trembling_does_not():
    progress = started()
    assert not progress.note(11.0, 4.95, 1.0)
    assert progress.stuck(16.5, 6.0)
    assert progress.note(12.0, 4.85, 1.0)
    assert not progress.stuck(17.9, 6.0)
    assert progress.stuck(18.1, 6.0)


def test_creeping_adds_up():
    progress = started()
    gained = [progress.note(10.0 + 0.1 * k, 5.0 - 0.015 * k, 1.0) for k in range(100)]
    assert sum(gained) == 14
    assert not progress.stuck(21.0, 6.0)


def test_turning_to_the_target_counts_on_either_side():
    progress = started()
    assert not progress.note(13.0, 5.0, -0.75)
    assert not progress.stuck(18.9, 6.0)
    progress.note(15.0, 5.0, 0.9)  # away again, which is none
    assert progress.stuck(19.1, 6.0)


def test_turning_to_and_fro_is_no_progress():
    progress = started()
    for k in range(100):
        progress.note(10.0 + 0.1 * k, 5.0, 0.4 if k % 2 else 1.2)
    assert progress.stuck(17.0, 6.0)


def test_another_path_may_be_longer_and_the_clock_goes_on():
    progress = started()
    progress.rebase()
    assert not progress.note(12.0, 9.0, 1.0)
    assert progress.stuck(16.1, 6.0)
    assert progress.note(12.5, 8.8, 1.0)
    assert not progress.stuck(16.1, 6.0)


def test_out_of_sight_counts_from_when_it_was_seen_last():
    progress = started()
    progress.note_sight(11.0, True)
    progress.note_sight(12.9, False)
    assert not progress.unseen(12.9, 2.0)
    assert progress.unseen(13.1, 2.0)
    progress.restart(13.1)
    assert not progress.unseen(13.1, 2.0)


def test_a_robot_dwells_while_it_stays_within_a_metre():
    progress = Progress()
    assert not progress.dwells(100.0, (3.0, 4.0), 15.0)
    assert not progress.dwells(110.0, (3.9, 4.0), 15.0)
    assert progress.dwells(116.0, (3.0, 4.9), 15.0)
    assert not progress.dwells(117.0, (4.1, 4.0), 15.0)  # a metre on it counts anew
    assert not progress.dwells(131.9, (3.3, 4.0), 15.0)
    assert progress.dwells(132.1, (3.3, 4.0), 15.0)
