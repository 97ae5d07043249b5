"""Print the commands of a README: the lines of its ``bash`` blocks, in order."""

import re
import sys
from pathlib import Path

text = Path(sys.argv[1]).read_text(encoding="utf-8")
for block in re.findall(r"^```bash\n(.*?)^```", text, flags=re.MULTILINE | re.DOTALL):
    for line in block.splitlines():
        if line.strip() and not line.startswith("#"):
            print(line)
