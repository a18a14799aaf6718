"""Files of strangers, read by a process that can do little harm and may die.

    Parser            a few such processes; hands in files, hands out checked data
      ParserProcess   one of them, as the service sees it: ask, wait, kill
      Launcher        a process that imports everything and forks them: `launching` runs in it
        child         what runs in them: waits for a question, answers, waits
          confinement what it may not do: much memory, much time, harm to anybody else, by
            system_calls, readable_folders, capabilities
          tasks       what it can be asked, by `raysvc.loading`
      message         questions and answers as bytes: JSON and raw arrays, nothing that runs
      scene_message   scenes, environments and pictures as messages, checked when they are read

An answer comes from a process that has read hostile bytes, so it is trusted no more than they are:
it is copied out of that process's reach first, and checked afterwards.
"""

from raysvc.parsing.options import DEFAULT_OPTIONS, ParserOptions
from raysvc.parsing.parser import Parser

__all__ = ["DEFAULT_OPTIONS", "Parser", "ParserOptions"]
