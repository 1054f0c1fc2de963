"""IEEE 802.11b link, contention and ad hoc routing: delays or drops every frame."""
