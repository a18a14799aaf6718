"""The lens: circles of confusion from depth (`coc`), blur by spreading pixels (`spread`)."""
