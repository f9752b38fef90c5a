"""`python -m pylmc` is the `pylmc` command."""

import sys

from .cli import main

sys.exit(main())
