from evenroad.task.result import TaskResult as TaskResult
from evenroad.task.steps import Attach as Attach
from evenroad.task.steps import Detach as Detach
from evenroad.task.steps import MoveTo as MoveTo
from evenroad.task.steps import Wait as Wait
from evenroad.task.task import Task as Task
from evenroad.task.task_file import TaskFile as TaskFile
from evenroad.task.task_file import load_task as load_task
