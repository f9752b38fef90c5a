"""`python -m pylmc` is the `pylmc` command."""

import sys

from .cli.commands import main

sys.exit(main())
