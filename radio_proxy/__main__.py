from onehop.node import startup
from radio_proxy.process import main

startup.main(main)
