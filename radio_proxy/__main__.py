from onehop.drive import node
from radio_proxy.process import main

node.main(main)
