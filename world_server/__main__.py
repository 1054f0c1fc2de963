from onehop.node import startup
from world_server.process import main

startup.main(main)
