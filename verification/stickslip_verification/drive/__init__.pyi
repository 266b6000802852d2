from .description import FmuError as FmuError
from .instance import FmuFile as FmuFile
from .masters import CommunicationStep as CommunicationStep
from .masters import Setting as Setting
from .masters import run as run
