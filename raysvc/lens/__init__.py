"""The lens: circles of confusion from depth (`coc`), and blur by spreading every pixel (`spread`)."""
