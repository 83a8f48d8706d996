"""The documentation site: the pages of the repository, ordered, and typeset by MkDocs."""
