"""What passes between programs: MATLAB files, tables, tolerances, styles, shapes, and decks to convert."""

import struct

from answer import answered
from damage import damaged_bytes, damaged_text
from damaged_decks import DECKS
from damaged_results import result_seeds

from flexmb_cli.errors import DONE

TOLERANCES = """\
rtol = 1e-9
[kinds]
acceleration = { atol = 1e-6 }
velocity = 1e-7
[quantities]
"body.3.velocity.*" = { atol = 1e-6, rtol = 0 }
[files."*.h5"]
last_digit = 1
kinds = { omega = 0.5 }
"""
STYLE = """\
# for print
lines.linewidth : 0.8
axes.prop_cycle : cycler('color', ['#0072B2', '#D55E00', 'k'])
font.family : sans-serif
axes.grid : True
figure.figsize : 4, 3
text.usetex : False
legend.fontsize : small
"""
TRIANGLE = """\
facet normal 0 0 1
outer loop
vertex 0 0 0
vertex 1 0 0
vertex 0 1.5e-1 0
endloop
endfacet
"""


def table_seeds(folder):
    """Results, and what `export` makes of them."""
    result_seeds(folder)
    for path in sorted(set(folder.glob("*.h5")) - {folder / "study.h5"}):
        for form in ("mat", "csv"):
            done = answered(["export", str(path), "--to", form, "-o", str(path.with_suffix(f".{form}"))])
            assert done.code == DONE, done.errors


def compare_matlab_file(chance, seeds, work):
    return _compared(chance, seeds, work, ".mat", damaged_bytes)


def compare_table(chance, seeds, work):
    return _compared(chance, seeds, work, ".csv", damaged_text)


def _compared(chance, seeds, work, suffix, damage):
    files = [path for path in sorted(seeds.glob(f"*{suffix}")) if path.with_suffix(".h5").exists()]
    path = chance.choice(files)
    (work / f"x{suffix}").write_bytes(damage(chance, path.read_bytes(), chance.choice(files).read_bytes()))
    other = path if chance.random() < 0.5 else path.with_suffix(".h5")
    pair = [str(work / f"x{suffix}"), str(other)]
    options = chance.choice(([], ["--json"], ["--junit", str(work / "j.xml")]))
    return answered(["diff", *(pair if chance.random() < 0.5 else pair[::-1]), *options])


def compare_by_tolerances(chance, seeds, work):
    raw = damaged_text(chance, TOLERANCES.encode(), STYLE.encode())
    (work / "t.toml").write_bytes(raw)
    pair = [str(seeds / "OUT4-BAR.h5"), str(seeds / "OUT4-BAR.h5")]
    return answered(["diff", *pair, "--tolerances", str(work / "t.toml")])


def draw_in_style(chance, seeds, work):
    (work / "s.mplstyle").write_bytes(damaged_text(chance, STYLE.encode(), TOLERANCES.encode()))
    picture = ["-o", str(work / "x.svg"), "--style", str(work / "s.mplstyle"), "--width", "80"]
    return answered(["plot", str(seeds / "OUT4-BAR.h5"), "body.2.x", *picture])


def shape_seeds(folder):
    """A mechanism with a shape, and the shape as text and as bytes."""
    deck = (DECKS / "young" / "IN4-BAR.dat").read_text()
    (folder / "shape.dat").write_text(f"{deck}\nGEOMETRY\nSTL s.stl 2 1\nEND\n")
    (folder / "text.stl").write_text(f"solid s\n{40 * TRIANGLE}endsolid s\n")
    facet = struct.pack("<12fH", *(0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0.5), 0)
    (folder / "bytes.stl").write_bytes(bytes(80) + struct.pack("<I", 40) + 40 * facet)


def check_with_shape(chance, seeds, work):
    text, binary = (seeds / name for name in ("text.stl", "bytes.stl"))
    if chance.random() < 0.5:
        raw = damaged_text(chance, text.read_bytes(), binary.read_bytes())
    else:
        raw = damaged_bytes(chance, binary.read_bytes(), text.read_bytes())
    (work / "s.stl").write_bytes(raw)
    (work / "shape.dat").write_bytes((seeds / "shape.dat").read_bytes())
    command = chance.choice((["check"], ["convert", "--to", "exudyn", "-o", "-"]))
    return answered([*command, str(work / "shape.dat")])


CONVERTED = ("young/dynamics/IN-ANDREWS.dat", "young/dynamics/IN-BRICARD.dat", "dafms/spatial_rigid.DAT")
CONVERTED += ("dafms/motor_gear.DAT", "dafms/sliding_mass.DAT", "dafms/fourbar_rigid.DAT")


def convert_deck(chance, seeds, work):
    decks = [DECKS / name for name in CONVERTED]
    path = chance.choice(decks)
    raw = damaged_text(chance, path.read_bytes(), chance.choice(decks).read_bytes())
    (work / path.name).write_bytes(raw)
    form = chance.choice(("mjcf", "exudyn", "vsdf", "young", "dafms"))
    return answered(["convert", str(work / path.name), "--to", form, "-o", str(work / "new")])
