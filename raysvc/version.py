"""The version, said once; it is part of what names a result."""

VERSION = "0.1.0"
