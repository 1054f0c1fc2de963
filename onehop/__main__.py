from onehop.cli import main

main()
