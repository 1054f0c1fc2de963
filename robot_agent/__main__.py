from onehop.drive import node
from robot_agent.process import main

node.main(main)
