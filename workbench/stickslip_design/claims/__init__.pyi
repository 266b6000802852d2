from .all_claims import findings as findings
from .document import markdown as markdown
from .files import pages as pages
from .files import write as write
from .finding import Finding as Finding
from .plots import draw as draw
