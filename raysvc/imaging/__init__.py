"""Pictures as arrays: summed-area tables, tone mapping, encoding to files."""
