"""`python -m raysvc` is `raysvc`."""

from raysvc.cli import main

if __name__ == "__main__":
    main()
