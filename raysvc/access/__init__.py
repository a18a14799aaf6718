"""Who may do what: API keys, what they reach, and where they are kept.

    scopes.py      read < render < admin
    key.py         what a key looks like, and what is kept of it
    key_store.py   the keys of a service, in SQLite

Nothing here has heard of HTTP.
"""

from raysvc.access.key import ApiKey
from raysvc.access.key_store import KeyStore
from raysvc.access.scopes import Scope

__all__ = ["ApiKey", "KeyStore", "Scope"]
