"""Python made machine code: how it is compiled, kept on disk and known again."""
