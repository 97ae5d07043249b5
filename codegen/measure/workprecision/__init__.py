"""Run time against error: cases, references, programs side by side, and what comes of them."""
