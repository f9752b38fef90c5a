"""Scenes described once and rendered by pylmc and by Mitsuba 3, and the tests that compare pictures pixel by pixel."""
