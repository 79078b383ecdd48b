"""Cards of bodies with rotations that cannot be meant, and what their matrices lack, at their places."""

from types import SimpleNamespace

import numpy as np
import pytest

from flexmb_cli.dialects.vsdf.build import build_model
from flexmb_cli.errors import ModelError
from flexmb_cli.fe.formats.matrix_file import FEFileFault, MatrixFile
from flexmb_cli.fe.rows import MOST_DENSE_ROWS, row_matrices
from tests.dialects.vsdf.vsdf_decks import read
from tests.fe.row_bodies.row_decks import FILES, HERE, body_of, free_deck

ARM = "ARMN\n    1,901,101,0.0,0.0,1.0\n"


@pytest.mark.parametrize(
    ("more", "id", "line"),
    [
        ("ARMN\n    1,103,101,0.0,0.0,1.0\n", "VSDF-219", "1,103,101"),
        ("ARMN\n    1,901,199,0.0,0.0,1.0\n", "VSDF-220", "1,901,199"),
        ("DAMF\n    1,50.0,-0.1\n", "VSDF-221", "1,50.0,-0.1"),
        ("DAMF\n    1,50.0,0.1\n    1,50.0,0.2\n", "VSDF-222", "1,50.0,0.2"),
        ("DAMF\n    1,50.0,0.1\nDAMP\n    1,,,0.1\n", "VSDF-223", "1,,,0.1"),
        (ARM + "JOIN\n    1,REVO,1,103,901,0,,,\n", "VSDF-225", "1,REVO"),
        ("TORQ\n    1,0.0,0.0,1.0\n", "VSDF-066", "1,0.0,0.0,1.0"),
        ("ARMN\n    1,911,103,0.0,0.0,1.0\nOUTN\n    1,911,\n", "MODEL-061", "1,911,103"),
        ("TORQ\n    1,0.0,0.0,1.0,,,103\n", "MODEL-062", "1,0.0,0.0,1.0,,,103"),
    ],
)
def test_what_cannot_be_done_is_refused_at_its_card(more, id, line):
    """In `beam_n6` node 103 has no rotations."""
    text = free_deck(FILES, "BDF beam_n6.pch", "DMIG beam_n6.pch", "DMIG beam_n6.pch", more=more)
    with pytest.raises(ModelError) as refused:
        build_model(read(text), HERE)
    found = {fault.id: fault.place for fault in refused.value.faults if fault.severity == "error"}
    assert text.splitlines()[found[id].line - 1].strip().startswith(line)


def test_a_torque_on_a_rigid_body_has_no_node():
    text = free_deck(FILES, "BDF beam_n6.pch", "DMIG beam_n6.pch", "DMIG beam_n6.pch")
    rigid = "    2,RIGD,\nRIGI\n    2,1.0,\n    1.0,1.0,1.0,\nTORQ\n    2,0.0,0.0,1.0,,,5\n"
    text = text.replace("1,FLEX,0,\n", f"1,FLEX,0,\n{rigid}")
    with pytest.raises(ModelError) as refused:
        build_model(read(text), HERE)
    assert "VSDF-224" in [fault.id for fault in refused.value.faults]


def test_a_node_of_the_table_without_rows_bears_nothing(tmp_path):
    (tmp_path / "four.txt").write_text((FILES / "beam_nodes.txt").read_text() + "104 2 0 0\n")
    files = "TXT four.txt", "ABQ beam_g_MASS1.mtx", "ABQ beam_g_STIF1.mtx"
    text = free_deck(FILES, *files, more="OUTN\n    1,104,\n")
    with pytest.raises(ModelError) as refused:
        build_model(read(text.replace(f"{FILES}/four.txt", f"{tmp_path}/four.txt")), HERE)
    assert "no rows of all three displacements of node 104" in refused.value.faults[-1].message


def test_more_rows_than_full_matrices_can_have_are_refused_before_any_work():
    count = MOST_DENSE_ROWS // 6 + 1
    numbers = np.arange(1, count + 1)
    labels = np.column_stack([np.repeat(numbers, 6), np.tile(np.arange(1, 7), count)])
    every = np.arange(len(labels))
    file = MatrixFile(len(labels), every, every, np.ones(len(labels)), True, labels)
    table = SimpleNamespace(numbers=numbers, positions=np.zeros((count, 3)), axes=None)
    with pytest.raises(FEFileFault, match=f"has {6 * count} rows with rotations or modal rows") as refused:
        row_matrices(("M", "K"), (file, file), table)
    assert refused.value.id == "FE-133"


def test_rows_without_names_that_fit_no_node_are_refused():
    file = MatrixFile(8, np.arange(8), np.arange(8), np.ones(8), True)
    table = SimpleNamespace(numbers=np.array([1, 2]), positions=np.zeros((2, 3)), axes=None)
    with pytest.raises(FEFileFault) as refused:
        row_matrices(("M", "K"), (file, file), table)
    assert refused.value.id == "FE-147"


def test_damping_ratios_by_frequency_are_on_straight_lines():
    """D = 2 ζ(f) ω; ζ between 50 and 110 Hz from 1 to 3 %, constant beyond."""
    files = "BDF beam_n6.pch", "DMIG beam_n6.pch", "DMIG beam_n6.pch"
    more = "DAMF\n    1,110.0,0.03\n    1,50.0,0.01\n"
    body, _ = body_of(free_deck(FILES, *files, more=more))
    ratios = np.clip(0.01 + 0.02 * (body.frequencies - 50.0) / 60.0, 0.01, 0.03)
    assert np.diag(body.Dr) == pytest.approx(2.0 * ratios * 2.0 * np.pi * body.frequencies, rel=1e-12)
    assert ratios[0] < ratios[1] < ratios[2] == 0.03
