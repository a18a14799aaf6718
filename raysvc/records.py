"""Records: tuples of arrays with one row for each point or ray, whole as kernels take them.

A record is a NamedTuple whose fields are arrays of N rows, or records themselves. Those within may
also have no rows at all, if that is so in all records that are to be joined.
"""

from collections.abc import Sequence
from typing import Any, TypeVar

import numpy as np

Record = TypeVar("Record", bound=tuple[Any, ...])


def joined(parts: Sequence[Record]) -> Record:
    """Return the rows of one or more records, one after the other."""
    columns = [
        joined(column) if isinstance(column[0], tuple) else np.concatenate(column)
        for column in zip(*parts, strict=True)
    ]
    return _made(parts[0], columns)


def chosen(record: Record, index: Any) -> Record:
    """Return some rows by number or mask, as copies."""
    number = np.asarray(index)
    return _taken(record, np.flatnonzero(number) if number.dtype == np.bool_ else number)


def _taken(record: Record, number: Any) -> Record:
    # Of arrays with more than one column, `take` is four times as fast as an index
    return _made(
        record, [_within(c, number) if isinstance(c, tuple) else c.take(number, 0) for c in record]
    )


def _within(within: Record, number: Any) -> Record:
    return _taken(within, number) if len(within[0]) else within


def rows(record: Record, begin: int, end: int) -> Record:
    """Return rows begin..end as views, without a copy."""
    return _made(
        record, [rows(c, begin, end) if isinstance(c, tuple) else c[begin:end] for c in record]
    )


def _made(like: Record, columns: Sequence[Any]) -> Record:
    made: Record = type(like)(*columns)
    return made
