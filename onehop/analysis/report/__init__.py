"""`onehop report`: figures, and one page that shows a mission to somebody who was not there."""
