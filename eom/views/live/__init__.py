"""Live pages: the equations of a scene, integrated where they are looked at.

`page.page` makes one file of HTML from a scene: what can be changed (`knobs`), what can be left out
(`single`, `trees`: one right-hand side for every choice, made beforehand), equations (`equations`), the
generated JavaScript (`code`), and what of `eom/views/web` draws it.
"""
