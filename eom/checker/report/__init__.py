"""What was found, as data, text, JSON and page.

In: findings. Out: lines for a terminal, a file by `report.schema.json`, one page of HTML.
Imports: `eom.checker.judge`, `eom.checker.mean`, `eom.checker.read`, `eom.opening`, `eom.system`,
`eom.typeset`, `eom.worlds`.
"""
