// Stands for the standard library where a fuzzer does without it.
