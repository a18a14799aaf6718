"""The first two Sobol dimensions and their scrambling, bit by bit."""


def reversed_word(word):
    """32 bits in the opposite order."""
    return int(f"{word:032b}"[::-1], 2)


def second_sobol_dimension(index):
    """32-bit fraction of a point: direction numbers of the primitive polynomial x + 1."""
    fraction, direction = 0, 1 << 31
    while index:
        if index & 1:
            fraction ^= direction
        index >>= 1
        direction ^= direction >> 1
    return fraction


def nested_uniform_scramble(word, scrambled):
    """Rebuild a scramble from what it does to the bits above each bit of a word.

    Owen 1995: whether a bit is flipped depends on the bits above it and on nothing else, so it may
    be asked of a word that has zeros from that bit on.
    """
    result = 0
    for bit in range(31, -1, -1):
        above = word >> (bit + 1) << (bit + 1)
        flipped = scrambled(above) >> bit & 1
        result |= ((word >> bit & 1) ^ flipped) << bit
    return result
