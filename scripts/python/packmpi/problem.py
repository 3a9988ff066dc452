"""What a user can mend, in one sentence."""


class Problem(Exception):
    """What is wrong and what to do: a file that is no pack, a program that is not there."""
