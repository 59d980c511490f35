"""The paper's experiments and the benchmarks, each behind one `venus3d study` command."""
