"""The command line: `raysvc serve | render | compare | inspect | keys | bench | demo`.

Wrong input ends with exit code 2 and one line `error: field: message`; any other failure with 1;
Ctrl-C with 130.
"""

from raysvc.cli.app import main

__all__ = ["main"]
