"""`flexmb new`: a deck asked for at the keyboard, or from a pipe of answers."""

import io
import os
import re
import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ..dialects.recognise import dialect_named, every_dialect
from ..errors import ANALYSIS_FAILED, BAD_INPUT, DeckError, Fault, Place, compiler_style
from ..managed_files import refuse_unsafe
from ..run.outcome import Terminated
from .options.output_file import WrittenPlace
from .terminal.screen import notify, standard_output

if TYPE_CHECKING:
    from ..deck.dialogue import Form
    from ..deck.questions import Question

# The dialects that have a dialogue, and the decks that it writes.
_NAMES = {each.name: each.new_name for each in reversed([*every_dialect()]) if each.form}
*_FIRST, _LAST = _NAMES.values()
_KEYS = """\
Enter    take the value in [ ]        ?       explain the number
<        previous question            < NAME  back to a record, such as: < driver.1
>        skip to the first unanswered question
!        stop; {stop}
A line may hold one number, or as many as the record has left."""
_KEPT = "the answers are kept in a draft, from which the next call continues"
_LOST = "the answers are not kept (--draft keeps them)"


@click.command()
@click.argument("dialect", type=click.Choice(list(_NAMES)))
@click.option(
    "-o",
    "--output",
    type=WrittenPlace(),
    metavar="PATH",
    help=f"Deck to write, - for standard output; {', '.join(_FIRST)} or {_LAST} if not given.",
)
@click.option("--force", is_flag=True, help="Replace a deck that is there already.")
@click.option("--restart", is_flag=True, help="Forget the draft of an earlier call.")
@click.option("--draft", "with_draft", is_flag=True,
              help="Keep a draft, and continue one, in a pipe, too.")  # fmt: skip
@click.option("--cards", is_flag=True,
              help="Ask for masses and loads, too, card by card (YOUNG).")  # fmt: skip
def new(dialect: str, output: str, force: bool, restart: bool, with_draft: bool, cards: bool) -> None:
    """Ask for the data of a deck, number by number, and write a deck that `flexmb check` accepts.

    Every answer is checked at once.  The answers are kept in PATH.draft until the deck is written, and the
    next call continues from there.  Answers may also come through a pipe, a line each; there a wrong one
    ends the dialogue, and nothing is kept.

    \b
    Example:
        flexmb new young -o IN-CRANK.dat
    """
    path = output or _NAMES[dialect]
    form = _form(dialect, cards, path)
    _ask_to_replace(path, force)
    talk = _Talk(form, path, restart, with_draft)
    try:
        talk.run()
    except KeyboardInterrupt:
        talk.say_kept("interrupted")
        sys.exit(130)
    except Terminated:
        talk.say_kept("terminated")
        sys.exit(143)


def _ask_to_replace(path: str, force: bool) -> None:
    if os.path.isdir(path):
        raise click.UsageError(f"{path} is a folder; -o names the deck to write")
    if path != "-":
        from ..results.files.replaced_file import refuse_unwritable

        refuse_unwritable(path)
    if force or path == "-" or not os.path.lexists(path) or not os.path.isfile(path):
        return
    if not sys.stdin.isatty():
        raise click.UsageError(f"{path} is there already; --force replaces it")
    if not click.confirm(f"{path} is there already; replace it?", default=False, err=True):
        sys.exit(BAD_INPUT)


def _form(name: str, cards: bool, path: str) -> "Form":
    dialect = dialect_named(name)
    form: Form = dialect.part(dialect.form)(Path(path).parent, cards)
    if cards and not form.has_cards:
        raise click.UsageError(f"new {name} asks for all cards without --cards")
    return form


class _Talk:
    """The dialogue at a terminal or through a pipe."""

    def __init__(self, form: "Form", path: str, restart: bool, with_draft: bool):
        self.path = path
        self.draft = "flexmb.draft" if path == "-" else f"{path}.draft"
        self.at_terminal = sys.stdin.isatty()
        # Who pipes answers has them: a second try begins with the first of them, and not after a draft.
        self.keeps_draft = self.at_terminal or with_draft
        # A title in another character code is no reason to lose the answers after it.
        if isinstance(sys.stdin, io.TextIOWrapper):
            sys.stdin.reconfigure(errors="replace")
        self.lines: list[Any] = []  # of a pipe, for the places of faults
        self.dialogue = self._begin(form, restart)

    def _begin(self, form: Any, restart: Any) -> Any:
        from ..deck.dialogue import Dialogue, from_draft
        from ..deck.text import read_text

        if self.keeps_draft:
            refuse_unsafe(self.draft)
        if restart or not os.path.lexists(self.draft):
            return Dialogue(form)
        if not self.keeps_draft:
            notify(
                f"{self.draft}: note: the draft of an earlier call is left alone: answers through a pipe "
                "begin again; --draft continues it"
            )
            return Dialogue(form)
        try:
            dialogue = from_draft(form, read_text(self.draft).text)
        except DeckError as failure:
            click.echo(compiler_style(self.draft, failure.faults), err=True)
            sys.exit(failure.exit_code)
        notify(f"{self.draft}: continuing with {len(dialogue.values)} answers; --restart begins again")
        return dialogue

    @property
    def _keys(self) -> Any:
        return _KEYS.format(stop=_KEPT if self.keeps_draft else _LOST)

    def run(self) -> None:
        """Ask until a deck stands that `check` accepts, and write it."""
        if self.at_terminal:
            click.echo(self._keys, err=True)
        while True:
            while (question := self.dialogue.question) is not None:
                self.take(question, self.ask(question))
            if self.accepted():
                break
        self.write()

    def ask(self, question: "Question") -> Any:
        """The answer to `question` as typed."""
        if not self.at_terminal:
            return self._next_line(question)
        if question.first == 0:
            click.echo(f"\n{question.entry.subject}", err=True)
        click.echo(f"  {question.text}", err=True)
        try:
            if sys.stdout.isatty():
                import readline  # noqa: F401 - its import gives input() arrow keys and a history

                return input(f"  {question.prompt}")
            # input() would write its question into a redirected standard output.
            click.echo(f"  {question.prompt}", nl=False, err=True)
            return self._next_line(question)
        except EOFError:
            return self.stop("end of input")

    def _next_line(self, question: "Question") -> str:
        line = sys.stdin.readline()
        if not line and question.entry.optional and not self.at_terminal:
            return ""
        if not line:
            self.stop("the answers end before the deck is complete")
        answer = line.rstrip("\r\n")
        self.lines.append(answer)
        return answer

    def take(self, question: "Question", line: str) -> None:
        """Obey a command, or give the answer to the machine; the draft follows every change."""
        word = line.strip()
        if word.startswith("?"):
            click.echo(f"{question.help(word[1:].strip())}\n{self._keys}", err=True)
        elif word == "!":
            self.stop("stopped")
        elif word == ">":
            self.show(self.dialogue.forward(), question)
        elif word.startswith("<"):
            self.go_back(word[1:].strip())
        else:
            self.show(self.dialogue.answer(line), question)
            self.keep()

    def go_back(self, name: str) -> None:
        """To the question before, or to the record called `name`."""
        if not name and not self.dialogue.back():
            self.show([Fault("error", "this is the first question", id="CLI-004")])
        elif name and not self.dialogue.back_to(name):
            message = f"there is no question {name} before this one; names are like driver.1"
            self.show([Fault("error", message, id="CLI-005")])

    def show(self, faults: Any, question: "Question | None" = None) -> Any:
        """Faults as sentences; in a pipe, where nobody can answer again, an error is the end."""
        if self.at_terminal:
            for fault in faults:
                click.echo(f"  {fault.severity}: {fault.sentence}", err=True)
            if faults and not any(fault.severity == "error" for fault in faults):
                click.echo("  (< leads back to this record)", err=True)
            return
        if faults:
            placed = [self._in_pipe(fault, question) for fault in faults]
            click.echo(compiler_style("-", placed, self.lines), err=True)
        if any(fault.severity == "error" for fault in faults):
            self.say_kept("a wrong answer")
            sys.exit(BAD_INPUT)

    def _in_pipe(self, fault: Any, question: Any) -> Any:
        """`fault` at its word of the last line, where it has one."""
        words = list(re.finditer(r"\S+", self.lines[-1])) if self.lines else []
        k = fault.place.column - 1 - question.first if fault.place and question else 0
        start, width = (words[k].start(), len(words[k][0])) if 0 <= k < len(words) else (0, 1)
        return replace(fault, place=Place(max(1, len(self.lines)), start + 1, width))

    def accepted(self) -> bool:
        """Return whether `flexmb check` takes the deck; else show its faults and let the dialogue go back."""
        from ..run.check.check import check_deck
        from ..run.outcome import RunOptions

        trial = self._trial()
        try:
            outcome = check_deck(trial.temporary, RunOptions(dialect=self.dialogue.form.dialect)).outcome
        finally:
            trial.discard()
        outcome.deck = self.path
        if outcome.faults:
            click.echo(compiler_style(self.path, outcome.faults, outcome.lines), err=True)
        if outcome.exit_code == 0:
            return True
        if not self.at_terminal:
            self.say_kept("the deck cannot be run as it is")
            sys.exit(outcome.exit_code)
        self._return_to(next((f for f in outcome.faults if f.severity == "error" and f.place), None))
        return False

    def _trial(self) -> Any:
        """The deck in a file to be removed; where this call is killed, the next one does it."""
        from ..results.files.replaced_file import ReplacedText

        # Beside its place, because a deck names matrices and node tables relative to itself.
        folder, name = os.path.split("deck" if self.path == "-" else self.path)
        trial = ReplacedText(os.path.join(folder, f"{name}.trial"))
        trial.write(self.dialogue.text)
        trial.flush()
        return trial

    def _return_to(self, fault: Any) -> None:
        """To the record that `check` names, else to the first; Enter keeps what is right."""
        if not (fault and self.dialogue.back_to_place(fault.place)):
            self.dialogue.back_to("counts")

    def write(self) -> Any:
        """The deck in its place, and the draft away."""
        from ..results.files.replaced_file import write_whole

        if self.path == "-":
            standard_output().write(self.dialogue.text)
        else:
            write_whole(self.path, self.dialogue.text.encode())
            notify(f"{self.path}: written; flexmb check {self.path} accepts it")
        if self.keeps_draft and os.path.lexists(self.draft):
            os.unlink(self.draft)

    def keep(self) -> Any:
        """Write the draft, whole or not at all, so that a closed terminal loses nothing."""
        if not self.keeps_draft:
            return
        from ..deck.dialogue import draft_text
        from ..results.files.replaced_file import write_whole

        refuse_unsafe(self.draft)
        write_whole(self.draft, draft_text(self.dialogue).encode())

    def say_kept(self, why: str) -> None:
        """Return why the dialogue ends, and where its answers are."""
        if not self.keeps_draft:
            where = "and no draft kept: give all answers again"
        elif os.path.lexists(self.draft):
            where = f"the answers so far are in {self.draft}, the next call continues"
        else:
            where = "nothing was answered"
        click.echo(err=True)
        notify(f"flexmb: {why}; no deck is written, {where}")

    def stop(self, why: str) -> None:
        """End without a deck (exit 1)."""
        self.say_kept(why)
        sys.exit(ANALYSIS_FAILED)
