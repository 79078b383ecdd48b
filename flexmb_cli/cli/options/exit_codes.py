"""The end of the help of every command: the meaning of exit codes; of the program also where to read on."""

DONE = {
    "run": "every deck is solved",
    "check": "every deck can be run",
    "verify": "the formulations agree",
    "diff": "no difference beyond tolerance",
    "sweep": "every case is solved",
    "flexmb": "done",
}
FAILED = {
    "run": "an analysis failed; the rows so far are kept and marked",
    "check": "the machine has too little memory",
    "verify": "an analysis failed, or the motions differ",
    "modes": "an analysis failed",
    "diff": "the results differ, or one is missing",
    "sweep": "some cases failed; the table is complete and says why",
    "flexmb": "an analysis failed, results differ, or the disk is full",
}
OF_ALL = {
    "2": "bad input: the call, a file that cannot be read, a deck with errors",
    "3": "a fault of flexmb itself; please report it",
    "130, 143": "interrupted by Ctrl-C; terminated",
}
READ_ON = [
    "",
    "\b",
    "Read on:",
    "  man flexmb               the manual (checkout: man -l docs/man/flexmb.1)",
    "  flexmb examples --all    decks, and their formats (decks/DIALECT/FORMAT.md)",
    "  docs/tutorial/index.md   lessons, in a checkout",
]


def exit_codes(command: str) -> dict[str, str]:
    """Return the meaning of every exit code of a command, "flexmb" for the program."""
    failed = FAILED.get(command, "a file cannot be written, for instance on a full disk")
    return {"0": DONE.get(command, DONE["flexmb"]), "1": failed} | OF_ALL


def epilog(command: str) -> str:
    """Return the lines that end the help of a command."""
    lines = [f"  {code:9} {meaning}" for code, meaning in exit_codes(command).items()]
    return "\n".join(["\b", "Exit codes:", *lines, *(READ_ON if command == "flexmb" else ())])
