"""Chains over light paths: the compiled scene, the start, the states, the film."""
