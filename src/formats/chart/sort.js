document.querySelectorAll("th").forEach(function(head,column){head.addEventListener("click",function(){
var body=head.closest("table").tBodies[0],rows=Array.from(body.rows),up=head.dataset.up!=="1";head.dataset.up=up?"1":"0";
var key=function(row){var cell=row.cells[head.cellIndex];return cell.dataset.value===undefined?cell.textContent:Number(cell.dataset.value)};
rows.sort(function(a,b){var x=key(a),y=key(b);return (x<y?-1:x>y?1:0)*(up?1:-1)});rows.forEach(function(row){body.appendChild(row)})})});
