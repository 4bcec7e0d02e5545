"""The reference pages of the documentation, made from the schema and the channel table."""
