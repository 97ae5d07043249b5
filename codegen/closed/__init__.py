"""Closed forms: the free body, the heavy top, the spinner, and where they are proved to hold."""
