"""What a user can mend, in one sentence."""
import argparse
from pathlib import Path


def named(words: str) -> Path:
    """The file or folder that an option names: an empty name would be the working folder."""
    if words:
        return Path(words)
    raise argparse.ArgumentTypeError("the name is empty")


class Problem(Exception):
    """What is wrong and what to do.

    code    as the program's exit codes: 2 a wish that cannot be, 4 numerical failure, 5 a file that is not there, damaged or cannot be
            written, 6 no checkpoint, 75 ended early
    """

    code: int = 5


class SceneError(Problem, ValueError):
    """A scene that is wrong.

    file    the scene's, as it was given; "scene.toml" for a dictionary
    line    of it, from 1; 0 where it is no matter of one line, or of a key that was changed by set=
    key     "particles.radius.mean"; "" where it is no matter of one key
    """

    file: str = ""
    line: int = 0
    key: str = ""


def of_failure(code: int, words: str, file: str, line: int, key: str) -> Problem:
    """The exception for what the compiled part throws, packmpi::Failure."""
    error = SceneError(words) if code == 2 and file else Problem(words)
    error.code = code
    if isinstance(error, SceneError):
        error.file, error.line, error.key = file, line, key
    return error
