"""The pure part of the radio: `Radio.carry(Truth) -> Carriage`."""
