from onehop.node import startup
from robot_agent.process import main

startup.main(main)
