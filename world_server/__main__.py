from onehop.drive import node
from world_server.process import main

node.main(main)
