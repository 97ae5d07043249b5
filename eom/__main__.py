"""The command line: list, derive, generate, accuracy, simulate, run, check, convert, plot, ...."""

from __future__ import annotations

import gc
import json
from collections.abc import Mapping
from typing import Any

import click

from eom.commands.analysing import analyse
from eom.commands.animating import animate, live
from eom.commands.benching import bench
from eom.commands.checking import check
from eom.commands.completing import completing, completion
from eom.commands.converting import convert
from eom.commands.deriving import derive
from eom.commands.ensembling import ensemble
from eom.commands.exercising import exercise
from eom.commands.generating import accuracy, generate
from eom.commands.linearising import linearise
from eom.commands.listing import list_names
from eom.commands.options import JSON, VALUES
from eom.commands.plotting import plot
from eom.commands.simulating import run, simulate
from eom.commands.stressing import stress
from eom.errors import InputError
from eom.limits import SELDOM

UNUSABLE, INTERRUPTED = 2, 130


class Commands(click.Group):
    """Turn input errors into one message and exit status 2, an interruption into status 130.

    Where a command prints JSON an error is printed so, too.
    """

    def invoke(self, ctx: click.Context) -> Any:
        """Run a command."""
        try:
            return super().invoke(ctx)
        except InputError as found:
            error = _of_option(found, ctx.meta.get(VALUES, {}))
            click.echo(f"error: {error}", err=True)
            if ctx.meta.get(JSON):
                parts = ("what", "where", "got", "expected", "hint")
                said = {part: getattr(error, part) for part in parts}
                click.echo(json.dumps({"error": said}, indent=2))
            ctx.exit(UNUSABLE)
        except (KeyboardInterrupt, RuntimeError) as error:
            if KeyboardInterrupt not in {type(error), type(error.__cause__)}:
                raise
            click.echo("interrupted", err=True)  # a class being made says RuntimeError of it
            ctx.exit(INTERRUPTED)
        except BrokenPipeError:
            raise  # the reader has seen enough; click ends quietly
        except OSError as error:
            click.echo(f"error: {error.strerror or error}", err=True)
            ctx.exit(UNUSABLE)


def _of_option(error: InputError, values: Mapping[str, str]) -> InputError:
    """Return the error of an initial value as one of the option `--set`, where that gave the value."""
    _, section, name = error.where.rpartition("[initial] ")
    return error.at(f"--set {name}={values[name]}") if section and name in values else error


BEGINNING = """\
eom: equations of motion, derived, turned into code and solved; derivations by hand, checked.

To begin with:
  eom derive bicycle-wheel              equations of a wheel, and what was left out of them
  eom run double-pendulum --out swing   equations, code in C, a trajectory, how good it is, a picture
  eom check note.md                     which line of a derivation is wrong, and why

Next: eom list names ready scenes and derivations, eom --help all commands, eom COMMAND --help one.
"""
"""What the program says that is called alone."""


@click.group(
    cls=Commands,
    invoke_without_command=True,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
)
@click.version_option(package_name="eom-toolkit", prog_name="eom")
@click.pass_context
def main(context: click.Context) -> None:
    """Derive equations of motion, generate code from them, integrate them, check hand derivations.

    SCENE is the name of a ready scene (see: eom list) or a file: .toml, or .urdf or MuJoCo's .xml
    for a robot. Exit status: 0 done; 1 the run stopped before its end, or something is wrong; 2
    unusable input; 130 interrupted. Colours are left out where NO_COLOR is set and where no terminal reads.
    """
    gc.set_threshold(*SELDOM)
    if context.invoked_subcommand is None:
        click.echo(BEGINNING, nl=False)


COMMANDS = (
    list_names, derive, generate, accuracy, simulate, run, ensemble, linearise, analyse,
    check, convert, bench, stress, animate, live, plot, exercise, completion,
)  # fmt: skip
for command in COMMANDS:
    main.add_command(completing(command))
main.add_command(linearise, "linearize")

if __name__ == "__main__":
    main(prog_name="eom")
