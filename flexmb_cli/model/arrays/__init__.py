"""Structured arrays that the kernels read, made from models."""
