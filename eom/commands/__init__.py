"""The commands of `eom`: one module a group of them; heavy packages are imported where they are used."""
