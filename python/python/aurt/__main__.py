"""The command `aurt`: `python -m aurt`."""

import sys

from ._aurt import main

if __name__ == "__main__":
    sys.exit(main())
